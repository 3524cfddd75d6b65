"""The tools, one module each with a function ``tool(services)`` that makes it."""
