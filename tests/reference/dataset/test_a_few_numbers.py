"""Five numbers of the golden dataset of Paris, as its files print them."""

from places import ROOT

GOLDEN = ROOT / "data/golden/paris"


def test_the_files_of_paris():
    grid = (GOLDEN / "grid.csv").read_text(encoding="utf-8").splitlines()
    transits = (GOLDEN / "transits.csv").read_text(encoding="utf-8").splitlines()
    assert grid[0] == "t,x,y,z,vx,vy,vz" and len(grid) == 1 + 1441  # a row each minute of a day
    assert grid[1].startswith("0,0.3000000000000000000000000000000000000000,0.4000")
    assert grid[2].startswith("60,-0.176326732960554274217")
    assert transits[1].startswith("1,8.21779242963629705033696080267374167,+1,")
    assert transits[2].startswith("2,16.43557333336698002417000146679438430,-1,")
