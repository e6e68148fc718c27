/* Where a message in an envelope goes next: to a place, by places, knowing only the neighbours.
 *
 * Greedy forwarding, face routing where that fails (GFG; Bose, Morin, Stojmenovic and Urrutia, "Routing with guaranteed delivery in
 * ad hoc wireless networks", 1999; GPSR; Karp and Kung, 2000). Greedy: to the neighbour with the greatest progress x quality of those nearer to
 * the destination, where progress is how much nearer; at equal quality that is the one nearest to the destination. Where none is nearer,
 * the message walks around the face of the Gabriel graph that the straight line to the destination enters, by the right-hand rule:
 * along the first edge counterclockwise from the line, then from each node along the first edge counterclockwise from the one it
 * came by. As soon as a neighbour is nearer to the destination than where the walk began, it goes on greedily to that.
 *
 * No change of faces is needed. Let the line from the beginning s to the destination d leave the face through the edge uv. Of the Gabriel
 * graph's edges, s and d lie outside the circle on the diameter uv and see it under at most 90 degrees; the angles of the quadrilateral
 * s u d v add up to 360, so it has one of at least 90 at u or at v, and that end is nearer to d than s. The walk comes by it, since
 * the border of a face of a connected graph is one closed walk (Frey and Stojmenovic, "On delivery guarantees of face and combined
 * greedy-face routing in ad hoc and sensor networks", 2006). If d is no node but a place, and inside the circle, every node beyond uv is at
 * least as far from d as the nearer of u and v, so the walk finds the node of the network that is nearest to the place.
 *
 * Guarantee: a message reaches its destination if a path of usable links does, where every two nodes within one and the same
 * horizontal distance, and no others, are neighbours; the links lose nothing for good; the places told are right; since the last
 * change every node has heard each neighbour twice; and no node has more than MH_NEIGHBOURS_MAX neighbours in the Gabriel graph, nor at its own place
 * (MH_NEIGHBOUR_PLANAR of neighbours.h is then not counted). A walk that comes to its first edge again has been all around, so
 * the destination cannot be reached: such a message is given up, unless it is for whoever stands nearest, who has been found.
 * Where radio links are no unit discs a message may be given up though a path exists; MH_ROUTE_HOPS_MAX bounds its way in any case.
 *
 * All in integers: predicates are exact for all places that a frame can carry. */
#ifndef MOTEHOUND_GEOGRAPHIC_H
#define MOTEHOUND_GEOGRAPHIC_H

#include "motehound/link.h"
#include "motehound/neighbours.h"

enum mh_hop {
    MH_HOP_NEXT,         /* to *next, as *leaving */
    MH_HOP_ARRIVED,      /* this node is the destination, or the nearest to the place if that was asked */
    MH_HOP_NO_NEIGHBOUR, /* none, or without face routing none nearer to the destination */
    MH_HOP_UNREACHABLE,  /* a whole face was walked around */
    MH_HOP_TOO_MANY      /* it has made MH_ROUTE_HOPS_MAX hops */
};

/* Put a message of this node into an envelope to `destination` at a place, or to the node nearest to that place (MH_BROADCAST).
 * `sequence` tells the node's messages apart. */
void mh_geographic_address(struct mh_message *message, mh_node_id origin, int16_t sequence, mh_node_id destination,
                           const struct mh_place *place);

/* The next hop of `message`, as it came in or was addressed -> *next and the message with the header that it takes there -> *leaving, which
 * are set with MH_HOP_NEXT only. `faces`: false for greedy forwarding alone. Cost: linear in the table; a square root per neighbour. */
enum mh_hop mh_geographic_next(const struct mh_neighbours *table, bool faces, const struct mh_message *message,
                               struct mh_message *leaving, mh_node_id *next);

/* The same for the message that is due on `link`, which is sent there with MH_HOP_NEXT; else it is still due. */
enum mh_hop mh_geographic_send(struct mh_link *link, const struct mh_neighbours *table, bool faces,
                               const struct mh_message *due);

/* Why a message is lost that has neither a next hop nor arrived. */
enum mh_loss mh_geographic_loss(enum mh_hop hop);

#endif
