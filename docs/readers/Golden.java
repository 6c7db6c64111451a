// Read a golden dataset in Java, as doubles from hexfloats: java Golden.java data/golden/paris
import java.io.IOException;
import java.nio.file.*;
import java.util.*;
import java.util.regex.*;

class Golden {
    /** The rows of a table by column, without its header; parseDouble reads decimals and hexfloats. */
    static List<Map<String, Double>> table(Path file) throws IOException {
        List<String> lines = Files.readAllLines(file);
        String[] header = lines.get(0).split(",");
        List<Map<String, Double>> rows = new ArrayList<>();
        for (String line : lines.subList(1, lines.size())) {
            String[] cells = line.split(",");
            Map<String, Double> row = new HashMap<>();
            for (int i = 0; i < cells.length; i++) row.put(header[i], Double.parseDouble(cells[i]));
            rows.add(row);
        }
        return rows;
    }

    public static void main(String[] args) throws IOException {
        Path folder = Path.of(args.length > 0 ? args[0] : ".");
        var grid = table(folder.resolve("grid.binary64.csv"));
        var last = grid.get(grid.size() - 1);
        System.out.println("grid " + grid.size() + "\nt " + last.get("t_hex"));
        String bounds = Files.readString(folder.resolve("manifest.json")).split("\"bounds\"")[1];
        for (String name : new String[] {"x", "y", "z", "vx", "vy", "vz"}) { // the first is the grid's
            Matcher bound = Pattern.compile("\"" + name + "\": \"(.*?)\"").matcher(bounds);
            bound.find();
            System.out.println(name + " " + last.get(name + "_hex") + " " + bound.group(1));
        }
        Path file = folder.resolve("transits.csv");
        if (!Files.exists(file)) return; // a scene without transits
        var transits = table(file);
        double largest = transits.stream().mapToDouble(row -> row.get("bound")).max().orElse(0);
        System.out.println("transits " + transits.size() + " " + largest);
    }
}
