use super::{metadata::Map, scene_update};

/// A topic of messages. Each topic has one channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Topic {
    /// Spawns and deletes.
    Events,
    /// States, one message per step.
    States,
    /// Keyframes.
    Bodies,
    /// Scene updates for viewers (optional).
    Scene,
}

const SPAWN: &str = include_str!("schemas/Spawn.msg");

impl Topic {
    /// All topics, in the order of their channels in a recording.
    pub const ALL: [Topic; 4] = [Topic::Events, Topic::States, Topic::Bodies, Topic::Scene];

    /// Returns the topic with this name.
    pub fn from_name(name: &str) -> Option<Topic> {
        Topic::ALL.into_iter().find(|topic| topic.name() == name)
    }

    /// The name of the topic.
    pub const fn name(self) -> &'static str {
        match self {
            Topic::Events => "/events",
            Topic::States => "/states",
            Topic::Bodies => "/bodies",
            Topic::Scene => "/scene",
        }
    }

    /// The name of the schema.
    pub const fn schema_name(self) -> &'static str {
        match self {
            Topic::Events => "rebond_msgs/msg/Event",
            Topic::States => "rebond_msgs/msg/State",
            Topic::Bodies => "rebond_msgs/msg/Bodies",
            Topic::Scene => "foxglove.SceneUpdate",
        }
    }

    /// The schema, followed by its dependencies in the format of `ros2msg`.
    pub fn schema(self) -> Vec<u8> {
        match self {
            Topic::Events => with_spawn(include_str!("schemas/Event.msg")),
            Topic::States => include_bytes!("schemas/State.msg").into(),
            Topic::Bodies => with_spawn(include_str!("schemas/Bodies.msg")),
            Topic::Scene => scene_update::SCHEMA.into(),
        }
    }

    /// The MCAP name of the encoding of the schema.
    pub const fn schema_encoding(self) -> &'static str {
        match self {
            Topic::Events | Topic::States | Topic::Bodies => "ros2msg",
            Topic::Scene => "protobuf",
        }
    }

    /// The MCAP name of the encoding of the messages.
    pub const fn message_encoding(self) -> &'static str {
        match self {
            Topic::Events | Topic::States | Topic::Bodies => "cdr",
            Topic::Scene => "protobuf",
        }
    }

    /// The metadata of the channel. ROS 2 requires the quality of service of all publishers; a recording has none.
    pub fn channel_metadata(self) -> Map {
        match self {
            Topic::Events | Topic::States | Topic::Bodies => Map::from([("offered_qos_profiles".into(), "[]".into())]),
            Topic::Scene => Map::new(),
        }
    }

    /// Returns true if every recording has the channel. The others are added with their first message.
    pub const fn is_mandatory(self) -> bool {
        match self {
            Topic::Events | Topic::States | Topic::Bodies => true,
            Topic::Scene => false,
        }
    }
}

fn with_spawn(schema: &str) -> Vec<u8> {
    let separator = "=".repeat(80);
    format!("{schema}{separator}\nMSG: rebond_msgs/Spawn\n{SPAWN}").into()
}
