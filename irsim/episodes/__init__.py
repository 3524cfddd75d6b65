"""Reading, running and explaining one episode."""
