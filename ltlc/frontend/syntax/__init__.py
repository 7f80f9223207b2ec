"""Text to a syntax tree: the grammar, the parser with its tables, and what to say of text that does not parse.

lark makes the tables, once, when the grammar changes (`python -m ltlc.frontend.syntax.generate`); the compiler reads
them as data and does not import lark. Where ROS's wheels are installed by pip, they bring an old `lark-parser`, which
unpacks into lark's own folder and overwrites it: a compiler that needed lark would break there. It also saves the 50
to 60 ms of the import. A test makes the tables anew and compares.
"""
