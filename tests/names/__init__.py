"""One name, one number: what commands, pages, tables, files and functions say under a name, held against each other."""
