"""From datasets of houses to the arrays of the engines: reader, generator, compiler, cache and bank."""
