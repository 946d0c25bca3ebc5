"""The kernels of cases, compiled before they are needed."""
