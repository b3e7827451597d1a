"""Speech columns of rows, on the device: answers, replies of an oracle, recipients of the instruction."""
