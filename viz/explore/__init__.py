"""The page on which one turns the hop's numbers, and the server that answers it on this machine."""
