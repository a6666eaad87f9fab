"""Problems of hybrid motion, with answers and error bounds, for any simulator; README.md describes them."""
