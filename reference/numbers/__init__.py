"""Numbers: their types and precisions, fixed-point tables and their columns, Taylor steps, sums of two doubles."""
