"""The version of this package, which is that of the project (a test compares them)."""

__version__ = "0.2.0.dev1"
