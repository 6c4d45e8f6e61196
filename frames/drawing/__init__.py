"""Pictures and VTK files of frames."""
