"""What computes a line: a protocol, two methods behind it, and the library of their kernels."""
