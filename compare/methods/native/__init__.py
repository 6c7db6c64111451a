"""Libraries of C and C++, used as their own users do: a program is written, compiled once, and run."""
