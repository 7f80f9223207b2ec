"""Many recordings: found, judged side by side on one machine or several, kept in a table, and reported together."""
