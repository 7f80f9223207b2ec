"""Work in child processes, bounded in time and memory."""
