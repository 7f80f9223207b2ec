"""What robots send and what was recorded: definitions of messages, recordings as rows and columns."""
