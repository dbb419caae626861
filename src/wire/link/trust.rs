//! Trust: whether the sender has the schemes of the receiver.

use super::Withheld;
use crate::Fingerprint;

/// What a receiver knows of the sender's schemes, since the sender's start.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trust {
    own: Option<Fingerprint>,
    /// That of all receivers which are joined.
    joint: Option<Fingerprint>,
    label: Option<Fingerprint>,
    standing: Standing,
    /// How many keyframes must agree before a sender with the same fingerprint is believed again.
    to_agree: u16,
}

/// So many keyframes must agree after each that contradicted.
const AGREE: u16 = 256;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Standing {
    /// Nothing has come yet.
    Unknown,
    /// The fingerprint of the receiver.
    Same,
    /// Another one.
    Other(Fingerprint),
    /// The sender has no fingerprint.
    Undescribed,
    /// Nor did its keyframes fit.
    Contradicted,
}

impl Trust {
    pub(super) const NONE: Self =
        Self { own: None, joint: None, label: None, standing: Standing::Unknown, to_agree: 0 };

    pub(super) const fn with_own(self, own: Fingerprint) -> Self {
        Self { own: Some(own), ..self }
    }

    pub(super) const fn with_label(self, label: &str) -> Self {
        Self { label: Some(Fingerprint::new(label)), own: None, ..self }
    }

    pub(super) const fn with_joint(self, joint: Fingerprint) -> Self {
        Self { joint: Some(joint), own: None, ..self }
    }

    pub(super) const fn has_own(&self) -> bool {
        self.own.is_some()
    }

    /// The receiver's own fingerprint: the one that it was given, or that of all joined receivers or this one, with its
    /// label.
    pub(super) fn own(&self, schemes: impl FnOnce() -> Fingerprint) -> Fingerprint {
        if let Some(own) = self.own {
            return own;
        }
        let joint = self.joint.unwrap_or_else(schemes);
        self.label.map_or(joint, |label| joint.and(label))
    }

    /// A sender has started.
    pub(super) fn begin(&mut self) {
        (self.standing, self.to_agree) = (Standing::Unknown, 0);
    }

    /// The sender has this fingerprint.
    pub(super) fn compare(&mut self, sender: Fingerprint) {
        let is_same = self.own == Some(sender);
        self.standing = if is_same { Standing::Same } else { Standing::Other(sender) };
    }

    /// The sender has no fingerprint.
    pub(super) fn lack(&mut self) {
        if self.standing == Standing::Unknown {
            self.standing = Standing::Undescribed;
        }
    }

    /// A keyframe contradicted an exact value. With the same fingerprint, items were lost without a word, or another bank
    /// has the same addresses.
    pub(super) fn contradict(&mut self) {
        if self.standing == Standing::Undescribed {
            self.standing = Standing::Contradicted;
        }
        self.to_agree = self.to_agree.saturating_add(AGREE);
    }

    /// A keyframe had the exact value before it.
    pub(super) fn agree(&mut self) {
        self.to_agree = self.to_agree.saturating_sub(1);
    }

    pub(super) const fn is_given(&self) -> bool {
        matches!(self.standing, Standing::Same | Standing::Undescribed) && self.to_agree == 0
    }

    /// Why no value is exact, if that is for want of trust in a sender that was heard.
    pub(super) fn doubt(&self) -> Option<Withheld> {
        match (self.standing, self.own) {
            (Standing::Other(sender), Some(own)) => Some(Withheld::Description { own, sender }),
            (Standing::Contradicted, _) => Some(Withheld::Contradicted),
            (Standing::Same, _) if self.to_agree > 0 => Some(Withheld::Contradicted),
            _ => None,
        }
    }
}
