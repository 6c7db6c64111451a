"""Golden datasets: the files of a solved scene, written, read, verified and evaluated."""
