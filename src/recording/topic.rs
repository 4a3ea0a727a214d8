use super::view;

/// What a message is about: each topic has a channel of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Topic {
    /// Spawns and deletes.
    Events,
    /// One message a step.
    States,
    /// Keyframes.
    Bodies,
    /// Boxes for viewers, if asked for.
    Scene,
}

const SPAWN: &str = include_str!("schemas/Spawn.msg");

impl Topic {
    /// Every topic, in the order in which a recording declares them.
    pub const ALL: [Topic; 4] = [Topic::Events, Topic::States, Topic::Bodies, Topic::Scene];

    /// The topic of that name.
    pub fn named(name: &str) -> Option<Topic> {
        Topic::ALL.into_iter().find(|topic| topic.name() == name)
    }

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Topic::Events => "/events",
            Topic::States => "/states",
            Topic::Bodies => "/bodies",
            Topic::Scene => "/scene",
        }
    }

    /// The name of its schema.
    pub const fn schema_name(self) -> &'static str {
        match self {
            Topic::Events => "rebond_msgs/msg/Event",
            Topic::States => "rebond_msgs/msg/State",
            Topic::Bodies => "rebond_msgs/msg/Bodies",
            Topic::Scene => "foxglove.SceneUpdate",
        }
    }

    /// Its schema, followed by those it needs, as ros2msg wants them.
    pub fn schema(self) -> Vec<u8> {
        match self {
            Topic::Events => with_spawn(include_str!("schemas/Event.msg")),
            Topic::States => include_bytes!("schemas/State.msg").into(),
            Topic::Bodies => with_spawn(include_str!("schemas/Bodies.msg")),
            Topic::Scene => view::SCHEMA.into(),
        }
    }

    /// The encoding of its schema, as MCAP calls it.
    pub const fn schema_encoding(self) -> &'static str {
        match self {
            Topic::Events | Topic::States | Topic::Bodies => "ros2msg",
            Topic::Scene => "protobuf",
        }
    }

    /// The encoding of its messages, as MCAP calls it.
    pub const fn message_encoding(self) -> &'static str {
        match self {
            Topic::Events | Topic::States | Topic::Bodies => "cdr",
            Topic::Scene => "protobuf",
        }
    }

    /// Whether every recording has it; any other is declared when its first message comes.
    pub const fn is_always_there(self) -> bool {
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
