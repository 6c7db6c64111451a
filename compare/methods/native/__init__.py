"""Libraries of C and C++: where they are here, and the parts in C++ of programs that use them as their users do."""
