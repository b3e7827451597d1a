"""Assets without nodes, such as of OBJ and COLLADA: their readers and bounds."""
