"""Recordings judged by columns: the same verdicts, times and reports as row by row, without a step for each."""
