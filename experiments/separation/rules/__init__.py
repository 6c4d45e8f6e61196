"""The separation that codes and the thesis' equations ask for between adjacent buildings."""
