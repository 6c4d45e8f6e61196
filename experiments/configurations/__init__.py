"""Every configuration of chapters 3 to 6 of the thesis as data, by name, and running one or all of them."""
