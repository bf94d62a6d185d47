# Scenario files, and what is said of mistakes in them.
cat > four.toml <<END
kind = "skin"
name = "four"
duration_s = 0.4

[[patch]]
columns = 4
rows = 1

[[interface]]
row = 0
column = 0
port = "W"

[[interface]]
row = 0
column = 3
port = "E"

[data]
rate_hz = 100

[[event]]
at_s = 0.3
action = "cut"
interface = 1
END
cat > links.txt <<END
A B 0.9 0.8
B C 0.7 0.9
C D 0.2
END
cat > worse.toml <<END
kind = "skin"
patch = 3
END
check four.toml
check four.toml --seed 3 --set protocol.k=3 --set event=[]
check radio-disaster
check radio-figure-1
check mesh-field
check mesh-team
check loop-three
new mesh mine.toml --network links.txt --min-tq 0.5
show mine.toml
new mesh mine.toml
new skin x.toml --network links.txt
new skin --types wifi
new mesh nowhere/x.toml
new car
check worse.toml
check nowhere.toml
check four.toml --set protocol.k
check four.toml --set protocol.k=999
check four.toml --set event.7.at_s=1
check four.toml --seed -1
check
check four.toml more
run four.toml --speed 3
compare four.toml four.toml
size robot.urdf --links skin --rate 0.001
size robot.urdf --links skin --loss 101
size robot.urdf --links skin --recovery 0
size robot.urdf --links skin --pitch 0.1
size robot.urdf --links skin --ports 3..1
size robot.urdf --links skin
export four.toml
export --graph g.json
export four.toml --csv --graph g.json
export four.toml --graph g.xml
export four.toml --graph g.json
show g.json
export four.toml --pcapng x.pcapng --from 5
export four.toml --pcapng x.pcapng --from 0.2 --to 0.1
fit four.toml
fit nowhere.pcapng
papers car
watch nowhere.toml
watch four.toml --speed -1
sweep four.toml --vary protocol.k
sweep four.toml --vary protocol.k=2,3 --repeat 0
sweep four.toml --vary protocol.k=2,3 --engine cloud
sweep four.toml --vary protocol.k=2,3 --until data.ci=x
live up four.toml --netns --pty
live up four.toml --for -1
live node nowhere.toml
live capture --for -1
live recovery nowhere.pcapng
