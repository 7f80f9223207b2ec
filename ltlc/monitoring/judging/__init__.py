"""Recordings judged: by columns where that can be, else row by row, and what is written of it."""
