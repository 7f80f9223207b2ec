"""Recordings judged: by rows, by columns, many at once, and for the tightest values."""
