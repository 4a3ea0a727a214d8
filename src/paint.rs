use crate::color::Color;

/// The colour that a scene gives a body and the image that is drawn into it; either may be absent.
///
/// This is the text that a recording stores: the colour and, after a space, the path of the image. Examples are
/// `#3366cc`, `#3366cc car.png` and ` car.png`. The digits of the colour keep their case.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Paint(String);

impl Paint {
    /// Joins a colour, `#rrggbb`, and the path of an image.
    pub fn new(color: Option<&str>, image: Option<&str>) -> Paint {
        let color = color.unwrap_or_default();
        Paint(image.map_or_else(|| color.into(), |image| format!("{color} {image}")))
    }

    /// Returns the text that a recording stores; empty without a colour and an image.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// Returns true if there is neither a colour nor an image.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the colour, if it is valid. That of a recording may be any text.
    pub fn color(&self) -> Option<Color> {
        self.color_text()?.parse().ok()
    }

    /// Returns the text of the colour.
    pub fn color_text(&self) -> Option<&str> {
        let color = self.0.split_once(' ').map_or(self.as_str(), |(color, _)| color);
        Some(color).filter(|color| !color.is_empty())
    }

    /// Returns the path of the image, relative to the folder of the scene.
    pub fn image(&self) -> Option<&str> {
        self.0.split_once(' ').map(|(_, image)| image).filter(|image| !image.is_empty())
    }
}

impl From<String> for Paint {
    fn from(recorded: String) -> Paint {
        Paint(recorded)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colour_and_image_are_read_back_from_the_recorded_text() {
        let blue = Some("#3366CC");
        for (color, image, recorded) in [
            (None, None, ""),
            (blue, None, "#3366CC"),
            (blue, Some("my car.png"), "#3366CC my car.png"),
            (None, Some("car.png"), " car.png"),
        ] {
            let paint = Paint::new(color, image);
            assert_eq!((paint.as_str(), paint.color_text(), paint.image()), (recorded, color, image));
            assert_eq!(paint.is_empty(), recorded.is_empty());
            assert_eq!(paint.color(), color.map(|_| Color::hex(0x3366cc)));
        }
        let recorded = Paint::from("red ".to_string());
        assert_eq!((recorded.color_text(), recorded.color(), recorded.image()), (Some("red"), None, None));
    }
}
