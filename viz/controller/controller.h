{% autoescape false %}
/* {{ title }}, written by spear-pin {{ version }}.
 *
 * Units: rad, rad/s, m, m/s, N.m, s. Coordinates q and their rates v:
{% for name, unit in coordinates %}
 *   q[{{ loop.index0 }}] {{ name }} [{{ unit }}], v[{{ loop.index0 }}] [{{ unit }}/s]
{% endfor %}
 * Torques u, at the joints:
{% for name, limit in joints %}
 *   u[{{ loop.index0 }}] {{ name }} [N.m]{{ ", at most %g" | format(limit) if limit else ", without a limit" }}
{% endfor %}
 *
 * Numbers of the law, which are constants in the source:
{% for name, value, unit in numbers %}
 *   {{ name }} = {{ value }}{{ " [" ~ unit ~ "]" if unit }}
{% endfor %}
 */
#ifndef SPEAR_CONTROLLER_H
#define SPEAR_CONTROLLER_H

#define SPEAR_COORDINATES {{ coordinates | length }}
#define SPEAR_JOINTS {{ joints | length }}
#define SPEAR_HELD {{ most_held }}
#define SPEAR_WATCHED {{ most_watched }}
#define SPEAR_LONGEST {{ longest }} /* s: a phase that lasts longer stops the controller */

enum { /* phases */
{% for phase in phases %}
  SPEAR_{{ phase.name | upper }}{{ "," if not loop.last }}
{% endfor %}
};

enum { /* events */
  SPEAR_STOPPED = -2, /* a phase lasts too long, or a signal is not finite: torques are zero */
  SPEAR_NOTHING = -1,
{% for event in events %}
  SPEAR_{{ event | upper }}{{ "," if not loop.last }}
{% endfor %}
};

/* What a controller remembers. Values held in
{% for phase in phases %}
 *   {{ phase.name }}: {{ phase.names | join(", ") }}
{% endfor %}
 */
typedef struct {
  int phase;
  double began;                 /* time at which the phase began, in s */
  int switches;                 /* scheduled events of the phase so far */
  double held[SPEAR_HELD];      /* values latched at events */
  int armed[SPEAR_WATCHED];     /* whether a watched value has been above zero */
  double threshold;             /* how near to zero counts as zero, >= 0, for noisy signals; set it after spear_init */
} spear_controller;

/* Begins at time t, in the air before the section (standing = 0) or on it, just after touchdown (standing = 1). */
void spear_init(spear_controller *c, int standing, double t, const double *q, const double *v);

/* Finds the events since the last call from q and v, and writes the torques, within their limits.
 * Returns the last event, SPEAR_NOTHING or SPEAR_STOPPED. The next call with sound signals gives torques again: whoever
 * wants to stay stopped has to call it no more. */
int spear_step(spear_controller *c, double t, const double *q, const double *v, double *u);

/* Tells the controller of an event that it has not found itself, for instance by a foot switch; v is after the impact.
 * Returns 0 if the present phase has no such event. */
int spear_event(spear_controller *c, int event, double t, const double *q, const double *v);

/* Writes the torques of the law without limits, and finds no event. */
void spear_torques(const spear_controller *c, double t, const double *q, const double *v, double *u);

#endif
{% endautoescape %}
