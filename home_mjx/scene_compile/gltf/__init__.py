"""Export of compiled houses as glTF."""
