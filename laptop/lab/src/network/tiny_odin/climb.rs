//! Hill climbing, which searches for the parameters of a neuron on the chip.

/// Searches for the choice of parameters with the smallest distance. Returns the smallest distance found, and its
/// choice. The search starts from the `climbs` best choices in `first`. It moves each of them to its best neighbour,
/// again and again, until no neighbour has a smaller distance.
///
/// The function `distance` computes the distance of a choice. Its second argument is a limit: the search only needs
/// exact distances below it. The function may stop as soon as the distance reaches the limit, and return any number
/// that is not below the limit. This saves time for most choices.
pub(super) fn climb<C: Copy, N: IntoIterator<Item = C>>(
    first: impl IntoIterator<Item = C>,
    neighbours: impl Fn(C) -> N,
    distance: impl Fn(C, f64) -> f64,
    climbs: usize,
) -> (f64, C) {
    let mut best: Vec<(f64, C)> = Vec::new();
    for choice in first {
        let most = best.get(climbs.max(1) - 1).map_or(f64::INFINITY, |(distance, _)| *distance);
        let distance = distance(choice, most);
        if distance < most || best.is_empty() {
            // Places a choice after those of equal distance, so that the first of equals wins.
            let place = best.partition_point(|(other, _)| *other <= distance);
            best.insert(place, (distance, choice));
            best.truncate(climbs.max(1));
        }
    }
    for (least, best) in best.iter_mut().take(climbs) {
        let mut is_better = *least > 0.0;
        while is_better {
            is_better = false;
            for choice in neighbours(*best) {
                let distance = distance(choice, *least);
                if distance < *least {
                    (*least, *best, is_better) = (distance, choice, true);
                }
            }
        }
    }
    let best = best.into_iter().min_by(|(one, _), (other, _)| one.total_cmp(other));
    best.expect("there is a choice at least")
}
