"""Numbers: types and precisions, fixed-point tables and columns, Taylor steps, double-doubles."""
