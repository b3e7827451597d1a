"""Rendering of moving sources and listeners (Doppler effect), and of reverberation longer than a response."""
