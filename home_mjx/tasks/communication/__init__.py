"""What rows say of speaking, on the device: answers, an oracle's replies, who is told what is to be done."""
