"""How ltlc is used: commands, Python, editors, the browser, and what is built for targets."""
