"""The third source paper, three methods for the Foucault pendulum, judged method by method."""
