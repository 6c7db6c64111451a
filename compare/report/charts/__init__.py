"""Charts of the reports as SVG text (matplotlib, extra `plot`): costs, precision, stability map, growth of errors.

Every function takes plain data and returns one SVG element for a page. Text stays text, and the same data give the same
bytes. The colours are Okabe and Ito's; markers, dashes and labels repeat their information, so nothing is lost in grey.
"""
