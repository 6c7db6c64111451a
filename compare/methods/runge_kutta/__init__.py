"""Explicit Runge-Kutta and Runge-Kutta-Nyström steps: tableaux that prove their order, traced and compiled."""
