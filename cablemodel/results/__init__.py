"""Runs: simulate, record, log, open, read as tables, compare, replay."""
