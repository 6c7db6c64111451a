"""The third source paper, which solves the linear pendulum by three methods: its sections in the order of print."""

SECTIONS = ("equations", "solutions")
