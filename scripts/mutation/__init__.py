"""Rules broken one at a time, to see whether a test finds it."""
