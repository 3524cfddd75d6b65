"""Cases: what is asked, and what must be true of an answer."""
