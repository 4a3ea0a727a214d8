/// What a message is about: each topic has a channel of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Topic {
    /// Spawns and deletes.
    Events,
    /// One message a step.
    States,
    /// Keyframes.
    Bodies,
}

/// The schema encoding of MCAP under which ours are known.
pub const SCHEMA_ENCODING: &str = "ros2msg";

/// The message encoding of MCAP under which ours are known.
pub const MESSAGE_ENCODING: &str = "cdr";

const SPAWN: &str = include_str!("schemas/Spawn.msg");

impl Topic {
    /// Every topic, in the order in which a recording declares them.
    pub const ALL: [Topic; 3] = [Topic::Events, Topic::States, Topic::Bodies];

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
        }
    }

    /// The name of its schema.
    pub const fn schema_name(self) -> &'static str {
        match self {
            Topic::Events => "rebond_msgs/msg/Event",
            Topic::States => "rebond_msgs/msg/State",
            Topic::Bodies => "rebond_msgs/msg/Bodies",
        }
    }

    /// Its schema, followed by those it needs, as ros2msg wants them.
    pub fn schema(self) -> String {
        match self {
            Topic::Events => with_spawn(include_str!("schemas/Event.msg")),
            Topic::States => include_str!("schemas/State.msg").into(),
            Topic::Bodies => with_spawn(include_str!("schemas/Bodies.msg")),
        }
    }
}

fn with_spawn(schema: &str) -> String {
    let separator = "=".repeat(80);
    format!("{schema}{separator}\nMSG: rebond_msgs/Spawn\n{SPAWN}")
}
