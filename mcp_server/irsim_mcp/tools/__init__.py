"""The tools, one module each: a function ``tool(services)`` that makes it."""
