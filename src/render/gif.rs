//! Pictures as an endless GIF animation.
