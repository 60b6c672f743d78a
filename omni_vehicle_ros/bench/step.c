/* The bare limit of the kernel: the equations of motion in the plane, with a Dugoff tyre, and the classical Runge-Kutta
 * method, as one would write them in C for one vehicle. `bench kernel` compiles this file by the system's compiler and
 * checks that it gives the numbers of omni_vehicle_ros.model, whose words it uses. No wind, no slip gains. */
#include <math.h>

#define STATE 10 /* vx, vy, r, x, y, psi, deflections */
#define LOOP_STEPS 12
#define BISECTIONS 64

static const double WALKING_PACE = 1.2, CREEPING_PACE = 0.3, HOLDING_PACE = 0.02, FASTEST_RELAXATION = 200.0;
static const double LARGEST_SLIP = 1.0, SMALLEST_SLIP = 1e-4, LOOP_TOLERANCE = 1e-11;
static const double MAXIMUM_SPEED = 1e3, MAXIMUM_YAW_RATE = 200.0;

typedef struct {
    double mass, yaw_inertia, gravity, wheel_x[4], wheel_y[4], front_load, rear_load, front_transfer, rear_transfer;
    double roll_per_acceleration, roll_steer[2], tyre_model, cornering_stiffness, longitudinal_stiffness;
    double adhesion_reduction, magic_shape, magic_curvature, sliding_share, stribeck_speed, full_stretch, friction_circle;
    double relaxation_length, low_speed_damping, rolling_hold;
} Constants; /* as `packed_constants` lays them out */

typedef struct {
    double steer_angle[4], drive_force[4], slip_gain[4], bank, wind, friction[4], steer_rate[4];
} Request; /* as `packed_request` lays them out, behind the state */

typedef struct {
    double v_long, v_lat, deflection, drive_force, load, friction, cos_steer, sin_steer;
} Contact;

typedef struct {
    double longitudinal, lateral;
} Force;

static double clamp(double value, double low, double high)
{
    return value < low ? low : value > high ? high : value;
}

static double low_speed_weight(double speed)
{
    double share = clamp((WALKING_PACE - speed) / (WALKING_PACE - CREEPING_PACE), 0.0, 1.0);
    return share * share * (3.0 - 2.0 * share);
}

static double largest_slip(const Contact *contact, const Constants *c)
{
    double slip = c->full_stretch * contact->friction * contact->load / c->cornering_stiffness;
    return clamp(slip, SMALLEST_SLIP, LARGEST_SLIP);
}

static double deflection_rate(const Contact *contact, double v_long, double v_lat, const Constants *c)
{
    double rolling = fabs(v_long), dragging = fabs(v_lat) / largest_slip(contact, c);
    double rate = (rolling > dragging ? rolling : dragging) / c->relaxation_length;
    if (rate <= FASTEST_RELAXATION)
        return -v_lat - rate * contact->deflection;
    return FASTEST_RELAXATION * (-v_lat / rate - contact->deflection);
}

static double side_force(double numerator, double denominator, double v_lat, double capacity, const Constants *c)
{
    double rest = 1.0 - c->adhesion_reduction * fabs(v_lat);
    double grip = rest > 0.0 ? capacity * rest : 0.0;
    double available = grip * denominator, needed = 2.0 * c->cornering_stiffness * fabs(numerator);
    if (available >= needed)
        return denominator > 0.0 ? c->cornering_stiffness * numerator / denominator : 0.0;
    return copysign(grip * (1.0 - 0.5 * available / needed), numerator);
}

static double slow_slip(const Contact *contact, double v_long, double v_lat, double weight, const Constants *c)
{
    double limit = largest_slip(contact, c), length = c->relaxation_length;
    double stretch = clamp(contact->deflection / length, -limit, limit);
    return stretch + c->low_speed_damping * weight * deflection_rate(contact, v_long, v_lat, c) / length;
}

static Force wheel_force(const Contact *contact, double cos_roll, double sin_roll, double load, const Constants *c)
{
    double v_long = contact->v_long * cos_roll + contact->v_lat * sin_roll;
    double v_lat = contact->v_lat * cos_roll - contact->v_long * sin_roll;
    double traction = contact->drive_force, capacity = contact->friction * load;
    double square = v_long * v_long + v_lat * v_lat;
    if (square < HOLDING_PACE * HOLDING_PACE) {
        double share = 1.0 - sqrt(square) / HOLDING_PACE;
        traction -= c->rolling_hold * share * share * v_long;
    }
    if (traction != 0.0) {
        traction = clamp(traction, -capacity, capacity);
        if (c->friction_circle != 0.0) {
            double rest = (capacity - traction) * (capacity + traction);
            capacity = rest > 0.0 ? sqrt(rest) : 0.0;
        }
    }
    if (square >= WALKING_PACE * WALKING_PACE)
        return (Force){traction, side_force(-v_lat, fabs(v_long), v_lat, capacity, c)};
    double weight = low_speed_weight(sqrt(square));
    double lateral = weight * side_force(slow_slip(contact, v_long, v_lat, weight, c), 1.0, v_lat, capacity, c);
    if (weight < 1.0)
        lateral += (1.0 - weight) * side_force(-v_lat, fabs(v_long), v_lat, capacity, c);
    return (Force){traction, lateral};
}

static double response(double ay, const Contact contacts[4], const Constants *c, Force forces[4])
{
    double roll = c->roll_per_acceleration * ay, total = 0.0;
    for (int axle = 0; axle < 2; axle++) {
        const Contact *left = &contacts[2 * axle];
        double transfer = (axle ? c->rear_transfer : c->front_transfer) * ay;
        double shift = clamp(transfer, -left->load, left->load);
        double cos_roll = cos(c->roll_steer[axle] * roll), sin_roll = sin(c->roll_steer[axle] * roll);
        for (int side = 0; side < 2; side++) {
            const Contact *contact = left + side;
            double load = side ? contact->load + shift : contact->load - shift;
            Force force = wheel_force(contact, cos_roll, sin_roll, load, c);
            total += force.longitudinal * contact->sin_steer + force.lateral * contact->cos_steer;
            forces[2 * axle + side] = force;
        }
    }
    return total / c->mass;
}

static double bisect(double limit, const Contact contacts[4], const Constants *c, Force forces[4])
{
    double low = -limit, high = limit;
    for (int number = 0; number < BISECTIONS; number++) {
        double middle = 0.5 * (low + high);
        if (response(middle, contacts, c, forces) > middle)
            low = middle;
        else
            high = middle;
    }
    return response(0.5 * (low + high), contacts, c, forces);
}

static double solve(const Contact contacts[4], const Constants *c, Force forces[4])
{
    double limit = 0.0, guess = 0.0, slope = 0.0, last = 0.0, gap_last = 0.0, gap_before_last = 0.0;
    for (int wheel = 0; wheel < 4; wheel++)
        limit += 3.0 * contacts[wheel].friction * contacts[wheel].load / c->mass;
    for (int number = 0; number < LOOP_STEPS; number++) {
        double reached = response(guess, contacts, c, forces), gap = reached - guess, step = gap;
        if (fabs(gap) <= LOOP_TOLERANCE * (1.0 + fabs(guess)))
            return reached;
        if (number > 0) {
            if (gap == gap_last || gap == gap_before_last)
                break;
            double slope_last = slope;
            slope = (guess - last) / (gap - gap_last);
            double bend = number > 1 ? (slope - slope_last) / (gap - gap_before_last) : 0.0;
            step = gap * (gap_last * bend - slope);
        }
        gap_before_last = gap_last;
        gap_last = gap;
        last = guess;
        guess = clamp(guess + step, -limit, limit);
    }
    return bisect(limit, contacts, c, forces);
}

static void state_rate(const double state[STATE], const Request *request, double time, const Constants *c,
                       int constant_speed, double rate[STATE])
{
    double vx = state[0], vy = state[1], r = state[2], level = cos(request->bank);
    Contact contacts[4];
    Force forces[4];
    for (int wheel = 0; wheel < 4; wheel++) {
        double angle = request->steer_angle[wheel] + time * request->steer_rate[wheel];
        double cos_steer = cos(angle), sin_steer = sin(angle);
        double along = vx - c->wheel_y[wheel] * r, across = vy + c->wheel_x[wheel] * r;
        double load = (wheel < 2 ? c->front_load : c->rear_load) * (level > 0.0 ? level : 0.0);
        double drive = constant_speed ? 0.0 : request->drive_force[wheel], friction = request->friction[wheel];
        contacts[wheel] = (Contact){along * cos_steer + across * sin_steer, across * cos_steer - along * sin_steer,
                                    state[6 + wheel], drive, load, friction > 0.0 ? friction : 0.0, cos_steer, sin_steer};
    }
    double ay = solve(contacts, c, forces), roll = c->roll_per_acceleration * ay, force_x = 0.0, moment = 0.0;
    for (int wheel = 0; wheel < 4; wheel++) {
        const Contact *contact = &contacts[wheel];
        Force force = forces[wheel];
        double forward = force.longitudinal * contact->cos_steer - force.lateral * contact->sin_steer;
        double leftward = force.longitudinal * contact->sin_steer + force.lateral * contact->cos_steer;
        force_x += forward;
        moment += c->wheel_x[wheel] * leftward - c->wheel_y[wheel] * forward;
    }
    for (int axle = 0; axle < 2; axle++) {
        double cos_roll = cos(c->roll_steer[axle] * roll), sin_roll = sin(c->roll_steer[axle] * roll);
        for (int wheel = 2 * axle; wheel < 2 * axle + 2; wheel++) {
            const Contact *contact = &contacts[wheel];
            double v_long = contact->v_long * cos_roll + contact->v_lat * sin_roll;
            double v_lat = contact->v_lat * cos_roll - contact->v_long * sin_roll;
            rate[6 + wheel] = deflection_rate(contact, v_long, v_lat, c);
        }
    }
    double cos_psi = cos(state[5]), sin_psi = sin(state[5]);
    rate[0] = constant_speed ? 0.0 : force_x / c->mass + vy * r;
    rate[1] = ay + c->gravity * sin(request->bank) - vx * r;
    rate[2] = moment / c->yaw_inertia;
    rate[3] = vx * cos_psi - vy * sin_psi;
    rate[4] = vx * sin_psi + vy * cos_psi;
    rate[5] = r;
}

static void moved(const double state[STATE], const double rate[STATE], double time, double out[STATE])
{
    for (int entry = 0; entry < STATE; entry++)
        out[entry] = state[entry] + time * rate[entry];
}

static void bound(double state[STATE])
{
    state[0] = clamp(state[0], -MAXIMUM_SPEED, MAXIMUM_SPEED);
    state[1] = clamp(state[1], -MAXIMUM_SPEED, MAXIMUM_SPEED);
    state[2] = clamp(state[2], -MAXIMUM_YAW_RATE, MAXIMUM_YAW_RATE);
}

/* Replaces the state at the head of a packed request by that at the end. */
void advance(double *state, const double *constants, long steps, double size, int constant_speed)
{
    const Request *request = (const Request *)(state + STATE);
    const Constants *c = (const Constants *)constants;
    double k1[STATE], k2[STATE], k3[STATE], k4[STATE], between[STATE];
    for (long number = 0; number < steps; number++) {
        double time = number * size;
        bound(state);
        state_rate(state, request, time, c, constant_speed, k1);
        moved(state, k1, 0.5 * size, between);
        state_rate(between, request, time + 0.5 * size, c, constant_speed, k2);
        moved(state, k2, 0.5 * size, between);
        state_rate(between, request, time + 0.5 * size, c, constant_speed, k3);
        moved(state, k3, size, between);
        state_rate(between, request, time + size, c, constant_speed, k4);
        for (int entry = 0; entry < STATE; entry++)
            state[entry] += size / 6.0 * (k1[entry] + 2.0 * (k2[entry] + k3[entry]) + k4[entry]);
    }
    bound(state);
}
