"""The formats: module ``x`` has the constant ``FORMAT`` of the format ``x``; modules ``_x`` help them."""
