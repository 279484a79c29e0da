"""Calls of a program, spread over the cores of this computer or over a Dask cluster."""
