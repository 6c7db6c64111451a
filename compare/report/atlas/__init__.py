"""The atlas: a page over golden datasets, and one for each of them that judges a dropped file in the browser."""
